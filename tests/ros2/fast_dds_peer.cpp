// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
//
// The other implementation of DDS: fast_dds_peer DOMAIN TYPE sends each message of rt/command back
// on rt/tool, byte by byte, until it is killed. Both have the DDS type TYPE.
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <unistd.h>

namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Message = std::vector<std::uint8_t>;

/// A type whose samples stay serialized.
class RawType final : public dds::TopicDataType {
 public:
  explicit RawType(const char* name) {
    setName(name);
    m_typeSize = 1U << 20U;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& message = *static_cast<Message*>(data);
    if (message.size() > payload->max_size) return false;
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(message.size());
    std::memcpy(payload->data, message.data(), message.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Message*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<Message*>(data)->size()); };
  }
  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

dds::DomainParticipantQos loopback_qos() {
  dds::DomainParticipantQos qos;
  auto transport = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  transport->interfaceWhiteList.emplace_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(transport);
  rtps::Locator_t peer;
  rtps::IPLocator::setIPv4(peer, "127.0.0.1");
  qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  return qos;
}

int run(std::uint32_t domain, const char* type_name) {
  dds::DomainParticipant* const participant =
      dds::DomainParticipantFactory::get_instance()->create_participant(domain, loopback_qos());
  if (participant == nullptr) return 1;
  dds::TypeSupport type(new RawType(type_name));
  type.register_type(participant);
  dds::Topic* const in = participant->create_topic("rt/command", type_name, dds::TOPIC_QOS_DEFAULT);
  dds::Topic* const out = participant->create_topic("rt/tool", type_name, dds::TOPIC_QOS_DEFAULT);
  dds::DataReaderQos reader_qos;
  reader_qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  reader_qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  dds::DataWriterQos writer_qos;
  writer_qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  writer_qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  dds::DataReader* const reader = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)
                                      ->create_datareader(in, reader_qos);
  dds::DataWriter* const writer =
      participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT)->create_datawriter(out, writer_qos);
  if (reader == nullptr || writer == nullptr) return 1;
  Message message;
  dds::SampleInfo info;
  while (true) {
    if (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) writer->write(&message);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  ::alarm(60);  // if the test is killed
  return run(static_cast<std::uint32_t>(std::atoi(argv[1])), argv[2]);
}
